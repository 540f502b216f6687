#pragma once
// Which of our errors an action ends with.
#include <string>

#include "sightcell/base/error.h"

namespace sightcell::test {

// Empty where nothing is thrown; other exceptions pass.
template <typename Action>
std::string error_id(const Action& action) {
  try {
    action();
  } catch (const error& e) {
    return e.id();
  }
  return {};
}

}  // namespace sightcell::test
