#pragma once
// Mutations that keep a .glb's lengths right: of its JSON as text, of one value of the JSON, or of its binary chunk.
// Bytes changed blindly die in the container or in the JSON parser, far before what is worth trying.
#include <cstddef>
#include <cstdint>

namespace fuzz {

using byte_mutator = std::size_t (*)(std::uint8_t* data, std::size_t size, std::size_t max_size);

// As LLVMFuzzerCustomMutator. What is neither .glb nor JSON, and one case in sixteen, is mutated as plain bytes.
std::size_t mutate_gltf(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed, byte_mutator bytes);

}  // namespace fuzz
