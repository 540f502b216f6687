#include "hemicube/gpu/gpu_timeline.h"

#include <algorithm>

namespace sightcell::bake {

gpu_timeline::~gpu_timeline() {
  for (const mark& m : marks_) glDeleteQueries(1, &m.query);
}

void gpu_timeline::start() {
  record(nullptr);
}

void gpu_timeline::end(const char* name) {
  record(name);
}

void gpu_timeline::record(const char* name) {
  if (!enabled_) return;
  GLuint query = 0;
  glCreateQueries(GL_TIMESTAMP, 1, &query);
  glQueryCounter(query, GL_TIMESTAMP);
  marks_.push_back({name, query});
}

std::vector<gpu_timeline::stage> gpu_timeline::stages() const {
  std::vector<stage> all;
  GLuint64 before = 0;
  for (const mark& m : marks_) {
    GLuint64 now = 0;
    glGetQueryObjectui64v(m.query, GL_QUERY_RESULT, &now);
    if (m.name != nullptr) {
      auto found = std::find_if(all.begin(), all.end(), [&](const stage& s) { return s.name == m.name; });
      if (found == all.end()) found = all.insert(found, {m.name, 0.0});
      found->seconds += 1e-9 * static_cast<double>(now - before);
    }
    before = now;
  }
  return all;
}

}  // namespace sightcell::bake
