#pragma once
// A tower block on a podium: a closed solid behind whatever hangs in front of it.
#include <string>

#include "mesh.h"
#include "plan.h"
#include "random.h"

namespace sightcell::city {

class tower {
 public:
  tower(std::string name, const lot& place, const style& s, random_stream& random);

  static constexpr double storey = 3.0;
  static constexpr double base = -4.0;  // below the ground it stands on

  bool has_body() const { return floors_ > 0; }
  const ring& podium() const { return podium_; }
  const ring& body() const { return body_; }
  double podium_low() const { return podium_low_; }
  double podium_high() const { return podium_high_; }
  std::uint32_t floors() const { return floors_; }  // above the podium
  double roof() const { return podium_high_ + floors_ * storey; }

  mesh build() const;
  double lift = 0;  // of its node: the ground it stands on

 private:
  std::string name_;
  ring podium_{}, body_{};
  double podium_low_ = base, podium_high_ = 7.0;
  std::uint32_t floors_ = 0;
  surface wall_ = surface::concrete;
  bool has_tank_ = false;
};

}  // namespace sightcell::city
