#pragma once
// The files that `sightcell bake` writes.
#include <filesystem>
#include <string>

#include "bake_options.h"

namespace sightcell::cli {

// A file that the bake writes must not be one that it reads, or another one that it writes.
// Fails with cli.output-is-input.
void refuse_overwriting(const bake_options& options);

// Rejects before the bake what could not be written after hours. Fails with output.io, cli.not-writable.
void refuse_bad_outputs(const bake_options& options);

// Rejects before the bake a scene that cannot contain or name the result. Fails as scene::with_embedded.
void refuse_bad_embedding(const bake_options& options);

// Writes the file of --json-file; removes it if it cannot be complete. Fails with cli.not-writable.
void write_summary(const std::filesystem::path& path, const std::string& text);

}  // namespace sightcell::cli
