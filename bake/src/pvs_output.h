#pragma once
// From finished cells to the .pvs file.
#include <filesystem>
#include <string>
#include <vector>

#include "cells/view_cell.h"
#include "checkpoint.h"
#include "sightcell/bake/bake.h"

namespace sightcell::bake {

// Encodes the stored cells and writes output by rename; fills in the summary. settings: the text for the file. Cells
// that were not stored are named in warnings. Throws sightcell::error when nothing can be stored or written.
void write_pvs(const scene::scene& s, const settings& how, const std::string& settings_text,
               const std::vector<view_cell>& cells, std::vector<cell_record>& records,
               const std::filesystem::path& output, const callbacks& tell, summary& sum);

}  // namespace sightcell::bake
