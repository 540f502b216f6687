#pragma once
// Each verb adds its options to the program, and sets the action to run if the command line names it.
#include <functional>

namespace CLI {
class App;
}

namespace sightcell::cli {

// Runs a verb after the command line is parsed. Returns an exit code; fails with sightcell::error.
using action = std::function<int()>;

void add_bake_verb(CLI::App& program, action& chosen);
void add_cells_verb(CLI::App& program, action& chosen);
void add_diff_verb(CLI::App& program, action& chosen);
void add_info_verb(CLI::App& program, action& chosen);
void add_merge_verb(CLI::App& program, action& chosen);
void add_migrate_verb(CLI::App& program, action& chosen);
void add_pack_verb(CLI::App& program, action& chosen);
void add_patch_verb(CLI::App& program, action& chosen);
void add_recode_verb(CLI::App& program, action& chosen);
void add_report_verb(CLI::App& program, action& chosen);
void add_samplers_verb(CLI::App& program, action& chosen);
void add_strip_verb(CLI::App& program, action& chosen);
void add_verify_verb(CLI::App& program, action& chosen);
void add_view_verb(CLI::App& program, action& chosen);

}  // namespace sightcell::cli
