#pragma once
// The one error type of the bake half. Every failure a user can meet is one line: id, what it is about, cause, what to
// do.
#include <stdexcept>
#include <string>
#include <utility>

namespace sightcell {

enum class error_kind { failed, wrong_use, bad_input };  // exit codes 1, 2 and 4 of the command line

class error : public std::runtime_error {
 public:
  // id: short and stable, "scene.index-out-of-range"; subject: the file or thing; cause: what is wrong with it;
  // remedy: what the user can do. what() is "subject: cause; remedy [id]".
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
