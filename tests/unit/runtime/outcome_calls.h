#pragma once
// Calls of the C API that return each status, by what they are about.
#include "outcomes.h"

namespace sightcell::test {

// outcomes_of_opening.cpp
void open_from_memory(outcomes& out);
void open_from_disk(outcomes& out);
void open_from_a_source(outcomes& out);
void open_without_waiting(outcomes& out);
void deliver_and_prefetch(outcomes& out);

// outcomes_of_files.cpp
void facts(outcomes& out);
void eyes(outcomes& out);
void identities(outcomes& out);
void names(outcomes& out);

// outcomes_of_views.cpp
void places(outcomes& out);
void sets_while_pending(outcomes& out);
void lists(outcomes& out);
void clusters(outcomes& out);
void clusters_of_files(outcomes& out);
void shadow_casters(outcomes& out);
void lamps(outcomes& out);
void residencies(outcomes& out);
void boxes(outcomes& out);
void importance(outcomes& out);

}  // namespace sightcell::test
