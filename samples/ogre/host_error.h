#pragma once
// One line about a failure that a user can meet.
#include <stdexcept>
#include <string>

namespace ogre_host {

class host_error : public std::runtime_error {
 public:
  // what() becomes "subject: cause; remedy [id]".
  host_error(const std::string& id, const std::string& subject, const std::string& cause, const std::string& remedy)
      : std::runtime_error(subject + ": " + cause + "; " + remedy + " [" + id + "]") {}
};

}  // namespace ogre_host
