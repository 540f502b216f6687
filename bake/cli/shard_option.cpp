#include "shard_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "sightcell/base/error.h"

namespace sightcell::cli {
namespace {

std::optional<std::uint32_t> number(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size() || text.empty()) return std::nullopt;
  return value;
}

[[noreturn]] void refuse_option(const std::string& text) {
  throw error(error_kind::wrong_use, "shard.bad-option", "--shard", "is \"" + text + "\"",
              "give i/n with i from 0 to n - 1, array, or array/n");
}

// A variable that is set must be a number.
std::optional<std::uint32_t> read(const environment& variables, const char* name) {
  const char* value = variables(name);
  if (value == nullptr) return std::nullopt;
  if (const auto read_number = number(value)) return read_number;
  throw error(error_kind::wrong_use, "shard.no-array", name, fmt::format("is \"{}\", no number", value),
              "give --shard i/n");
}

// The task's place and how many tasks there are, as far as the scheduler says; with a count given by hand, its number.
struct array_task {
  std::uint32_t index = 0;
  std::optional<std::uint32_t> count;
};

// Slurm numbers tasks as the user asked: 0-15, 1-16, 0-30:2. A list with gaps has a count that says nothing of n.
array_task slurm_task(const environment& variables, std::uint32_t id, bool count_is_given) {
  if (count_is_given) return {id, std::nullopt};
  const auto first = read(variables, "SLURM_ARRAY_TASK_MIN"), last = read(variables, "SLURM_ARRAY_TASK_MAX"),
             step = read(variables, "SLURM_ARRAY_TASK_STEP"), count = read(variables, "SLURM_ARRAY_TASK_COUNT");
  if (!first || !last || !count || id < *first || id > *last) return {id, std::nullopt};
  const std::uint32_t stride = std::max(step.value_or(1), 1u);
  if ((*last - *first) / stride + 1 != *count || (id - *first) % stride != 0)
    throw error(error_kind::wrong_use, "shard.no-array", "SLURM_ARRAY_TASK_COUNT",
                fmt::format("is {}, but tasks go from {} to {}: the array has gaps", *count, *first, *last),
                "give --shard array/n with the n of the whole bake, and tasks numbered from 0");
  return {(id - *first) / stride, count};
}

array_task task_of(const environment& variables, bool count_is_given) {
  if (const auto id = read(variables, "SLURM_ARRAY_TASK_ID")) return slurm_task(variables, *id, count_is_given);
  if (const auto index = read(variables, "JOB_COMPLETION_INDEX")) return {*index, read(variables, "JOB_COMPLETIONS")};
  if (const auto index = read(variables, "AWS_BATCH_JOB_ARRAY_INDEX"))
    return {*index, read(variables, "AWS_BATCH_JOB_ARRAY_SIZE")};
  throw error(error_kind::wrong_use, "shard.no-array", "--shard array",
              "finds no SLURM_ARRAY_TASK_ID, JOB_COMPLETION_INDEX or AWS_BATCH_JOB_ARRAY_INDEX", "give --shard i/n");
}

}  // namespace

bake::shard shard_of(const std::string& text, const environment& variables) {
  const std::size_t slash = text.find('/');
  const std::string_view before = std::string_view(text).substr(0, slash);
  std::optional<std::uint32_t> count;
  if (slash != std::string::npos && !(count = number(std::string_view(text).substr(slash + 1)))) refuse_option(text);
  bake::shard part;
  if (before == "array") {
    const array_task task = task_of(variables, count.has_value());
    part.index = task.index;
    if (!count) count = task.count;
    if (!count)
      throw error(error_kind::wrong_use, "shard.no-array", "--shard array", "cannot tell how many tasks there are",
                  "give --shard array/n");
  } else {
    const auto index = number(before);
    if (!index || !count) refuse_option(text);
    part.index = *index;
  }
  part.count = *count;
  if (part.index >= part.count)
    throw error(error_kind::wrong_use, "shard.out-of-range", "--shard", fmt::format("is {}/{}", part.index, part.count),
                "number shards from 0 to n - 1");
  return part;
}

}  // namespace sightcell::cli
