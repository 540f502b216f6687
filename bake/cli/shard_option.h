#pragma once
// --shard: which part of a bake this machine takes.
#include <functional>
#include <string>

#include "sightcell/bake/shards.h"

namespace sightcell::cli {

// Gives the value of an environment variable; null where there is none.
using environment = std::function<const char*(const char* name)>;

// "i/n"; "array": both from the variables of a Slurm array, an indexed Job of Kubernetes or an array job of AWS Batch;
// "array/n": i alone from there, for arrays that run only some of the shards. phase is left as it is. Throws
// sightcell::error (wrong_use) "shard.bad-option" or "shard.no-array".
bake::shard shard_of(const std::string& text, const environment& variables);

}  // namespace sightcell::cli
