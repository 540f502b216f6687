#pragma once
// A hemicube source that lives on a thread of its own and serves any number of others: for sources that only the thread
// that made them may call, like those with an OpenGL context.
#include <functional>
#include <memory>

#include "hemicube/hemicube_source.h"

namespace sightcell::bake {

// Makes, uses and destroys the source on a new thread, which ends with the result. Poses of several callers that wait
// at the same time are rendered in one call of the source. A caller sleeps until its views are there. make: is
// destroyed on the new thread too, after the source. Must not use TBB, and neither must the source. Throws what make
// throws. The result's render() throws what the source throws, to all callers whose poses were rendered together.
std::unique_ptr<hemicube_source> make_source_on_thread(std::function<std::unique_ptr<hemicube_source>()> make);

}  // namespace sightcell::bake
