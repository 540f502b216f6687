#pragma once
// A hemicube source that sees what a test says.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hemicube/hemicube_source.h"

namespace sightcell::test {

// Answers every bake::pose with what a function says, and remembers the poses and how many came together.
class scripted_source final : public bake::hemicube_source {
 public:
  std::function<void(const bake::pose&, bake::hemicube_view&)> answer = [](const bake::pose&, bake::hemicube_view&) {};
  std::vector<bake::pose> poses;
  std::vector<std::size_t> batches;
  using bake::hemicube_source::render;
  void render(std::span<const bake::pose> wanted, std::span<bake::hemicube_view> views) override {
    batches.push_back(wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      poses.push_back(wanted[i]);
      views[i] = {};
      answer(wanted[i], views[i]);
    }
  }
  void render_image(const bake::pose&, bake::hemicube_image&) override {}
  std::uint32_t resolution() const override { return 64; }
  std::string device() const override { return "scripted"; }
};

}  // namespace sightcell::test
