#pragma once
// The error type of the bake half. Each failure that a user can meet is one line with a stable id; bake/ERRORS.md lists
// the ids.
#include <stdexcept>
#include <string>
#include <utility>

namespace sightcell {

// The cause of a failure. The command line exits with 1, 2 and 4.
enum class error_kind {
  failed,     // the machine: disk, memory, graphics device
  wrong_use,  // the caller: options and settings
  bad_input   // a file or an array that the caller named
};

class error : public std::runtime_error {
 public:
  // what() becomes "subject: cause; remedy [id]", one line.
  // id: stable, "scene.index-out-of-range".
  // subject: the file, option or thing.
  // cause: what is wrong with it.
  // remedy: what the user can do.
  error(error_kind kind, std::string id, const std::string& subject, const std::string& cause,
        const std::string& remedy)
      : std::runtime_error(subject + ": " + cause + "; " + remedy + " [" + id + "]"), kind_(kind), id_(std::move(id)) {}

  error_kind kind() const noexcept { return kind_; }

  const std::string& id() const noexcept { return id_; }

 private:
  error_kind kind_;
  std::string id_;
};

}  // namespace sightcell
