// --shard by hand, and from what schedulers put into the environment.
#include "shard_option.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "errors/error_id.h"

namespace sightcell::cli {
namespace {

using variables = std::map<std::string, std::string>;

std::string read(const std::string& text, const variables& set = {}) {
  const bake::shard part = shard_of(text, [&](const char* name) -> const char* {
    const auto found = set.find(name);
    return found == set.end() ? nullptr : found->second.c_str();
  });
  return std::to_string(part.index) + "/" + std::to_string(part.count);
}

std::string refusal(const std::string& text, const variables& set = {}) {
  return test::error_id([&] { (void)read(text, set); });
}

variables slurm(const char* id, const char* first, const char* last, const char* count, const char* step = "1") {
  return {{"SLURM_ARRAY_TASK_ID", id},
          {"SLURM_ARRAY_TASK_MIN", first},
          {"SLURM_ARRAY_TASK_MAX", last},
          {"SLURM_ARRAY_TASK_COUNT", count},
          {"SLURM_ARRAY_TASK_STEP", step}};
}

TEST(shard_option, by_hand) {
  EXPECT_EQ(read("0/1"), "0/1");
  EXPECT_EQ(read("15/16"), "15/16");
  for (const char* bad : {"3", "/", "a/3", "3/", "1/b", "-1/3", "1/3/4", " 1/3", "99999999999/3", "array/x", "arrays"})
    EXPECT_EQ(refusal(bad), "shard.bad-option") << bad;
  EXPECT_EQ(refusal("3/3"), "shard.out-of-range");
  EXPECT_EQ(refusal("0/0"), "shard.out-of-range");
}

TEST(shard_option, slurm_arrays_may_begin_anywhere_and_take_steps) {
  EXPECT_EQ(read("array", slurm("3", "0", "15", "16")), "3/16");
  EXPECT_EQ(read("array", slurm("16", "1", "16", "16")), "15/16");
  EXPECT_EQ(read("array", slurm("20", "10", "30", "3", "10")), "1/3");
  EXPECT_EQ(refusal("array", slurm("7", "3", "7", "2")), "shard.no-array") << "tasks 3 and 7 of some bake";
  EXPECT_EQ(read("array/16", slurm("7", "3", "7", "2")), "7/16");
  EXPECT_EQ(refusal("array/5", slurm("7", "3", "7", "2")), "shard.out-of-range");
  EXPECT_EQ(refusal("array", {{"SLURM_ARRAY_TASK_ID", "3"}}), "shard.no-array");
  EXPECT_EQ(refusal("array/4", {{"SLURM_ARRAY_TASK_ID", "three"}}), "shard.no-array");
}

TEST(shard_option, kubernetes_and_aws) {
  EXPECT_EQ(read("array", {{"JOB_COMPLETION_INDEX", "2"}, {"JOB_COMPLETIONS", "8"}}), "2/8");
  EXPECT_EQ(refusal("array", {{"JOB_COMPLETION_INDEX", "2"}}), "shard.no-array");
  EXPECT_EQ(read("array/8", {{"JOB_COMPLETION_INDEX", "2"}}), "2/8");
  EXPECT_EQ(read("array", {{"AWS_BATCH_JOB_ARRAY_INDEX", "0"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "2"}}), "0/2");
  EXPECT_EQ(refusal("array"), "shard.no-array");
  EXPECT_EQ(refusal("array/4"), "shard.no-array");
}

}  // namespace
}  // namespace sightcell::cli
