#include "gltf_mutation.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace fuzz {
namespace {

using nlohmann::json;

struct parts {
  bool container = false;  // .glb
  std::string text, binary;
};

std::uint32_t u32_at(const std::uint8_t* at) {
  return static_cast<std::uint32_t>(at[0]) | static_cast<std::uint32_t>(at[1]) << 8 |
         static_cast<std::uint32_t>(at[2]) << 16 | static_cast<std::uint32_t>(at[3]) << 24;
}

bool split(const std::uint8_t* data, std::size_t size, parts& out) {
  if (size > 0 && data[0] == '{') {
    out.text.assign(data, data + size);
    return true;
  }
  if (size < 20 || std::memcmp(data, "glTF", 4) != 0) return false;
  const std::size_t json_size = u32_at(data + 12);
  if (json_size > size - 20) return false;
  out.container = true;
  out.text.assign(data + 20, data + 20 + json_size);
  const std::size_t rest = 20 + json_size;
  if (size >= rest + 8) out.binary.assign(data + rest + 8, data + size);
  return true;
}

void append_u32(std::string& out, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xFFu);
}

std::string joined(parts p) {
  if (!p.container) return p.text;
  p.text.resize((p.text.size() + 3) / 4 * 4, ' ');
  p.binary.resize((p.binary.size() + 3) / 4 * 4, '\0');
  std::string out = "glTF";
  append_u32(out, 2);
  append_u32(out, 28 + p.text.size() + p.binary.size());
  append_u32(out, p.text.size());
  out += "JSON" + p.text;
  append_u32(out, p.binary.size());
  return out + std::string("BIN\0", 4) + p.binary;
}

void mutate_bytes(std::string& text, std::size_t room, byte_mutator bytes) {
  std::vector<std::uint8_t> buffer(text.begin(), text.end());
  buffer.resize(text.size() + room + 1);
  const std::size_t size = bytes(buffer.data(), text.size(), text.size() + room);
  text.assign(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
}

// Every value inside, with the container that holds it.
struct place {
  json* holder;
  std::string key;        // in an object
  std::size_t index = 0;  // in an array
  json& value() const { return holder->is_object() ? (*holder)[key] : (*holder)[index]; }
};

void collect(json& root, std::vector<place>& out) {
  std::vector<json*> open = {&root};
  while (!open.empty() && out.size() < 20000) {
    json* const holder = open.back();
    open.pop_back();
    std::size_t index = 0;
    for (auto it = holder->begin(); it != holder->end(); ++it, ++index) {
      out.push_back({holder, holder->is_object() ? it.key() : std::string(), index});
      if (it->is_structured()) open.push_back(&*it);
    }
  }
}

json strange_number(std::mt19937& random, const json& old) {
  static const std::array<json, 22> extremes = {0,   1,     2,     3,          4,           5,          6,         255,
                                                256, 65535, 65536, 2147483647, 4294967295u, 4294967296, 1LL << 62, -1,
                                                0.5, -1.5,  1e-30, 1e30,       5126,        5121};
  switch (random() % 4) {
    case 0:
      return extremes[random() % extremes.size()];
    case 1:
      return old.is_number() && old.get<double>() < 1e15 && old.get<double>() > -1e15
                 ? json(static_cast<std::int64_t>(old.get<double>()) + static_cast<std::int64_t>(random() % 9) - 4)
                 : json(0);
    case 2:
      return old.is_number() && old.get<double>() < 1e15 && old.get<double>() > -1e15
                 ? json(static_cast<std::int64_t>(old.get<double>()) * static_cast<std::int64_t>(1 + random() % 4))
                 : json(1);
    default:
      return static_cast<std::uint64_t>(random() % 64);
  }
}

void mutate_value(json& document, std::mt19937& random) {
  std::vector<place> places;
  collect(document, places);
  if (places.empty()) return;
  const place& at = places[random() % places.size()];
  switch (random() % 8) {
    case 0:  // gone
      if (at.holder->is_object())
        at.holder->erase(at.key);
      else
        at.holder->erase(at.index);
      break;
    case 1: {  // another value of the document
      const json copy = places[random() % places.size()].value();
      at.value() = copy;
      break;
    }
    case 2:  // once more
      if (at.holder->is_array()) {
        const json copy = at.value();
        at.holder->push_back(copy);
      }
      break;
    case 3: {  // exchanged with another of the same name
      std::vector<const place*> same;
      for (const place& p : places)
        if (p.key == at.key && p.holder->is_object() == at.holder->is_object()) same.push_back(&p);
      const json copy = same[random() % same.size()]->value();
      at.value() = copy;
      break;
    }
    default: {  // a number
      std::vector<const place*> numbers;
      for (const place& p : places)
        if (p.value().is_number()) numbers.push_back(&p);
      if (numbers.empty()) break;
      json& value = numbers[random() % numbers.size()]->value();
      value = strange_number(random, value);
    }
  }
}

}  // namespace

std::size_t mutate_gltf(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed, byte_mutator bytes) {
  std::mt19937 random(seed);
  parts p;
  if (random() % 16 == 0 || !split(data, size, p)) return bytes(data, size, max_size);
  const std::size_t room = max_size > size + 32 ? std::min<std::size_t>(max_size - size - 32, 256) : 0;
  const unsigned choice = random() % 8;
  if (choice < 2 && !p.binary.empty()) {
    mutate_bytes(p.binary, room, bytes);
  } else if (choice == 2) {
    mutate_bytes(p.text, room, bytes);
  } else {
    json document = json::parse(p.text, nullptr, false);
    if (!document.is_structured()) return bytes(data, size, max_size);
    for (unsigned i = 0, times = 1 + random() % 3; i < times; ++i) mutate_value(document, random);
    p.text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  }
  const std::string out = joined(std::move(p));
  if (out.size() > max_size) return bytes(data, size, max_size);
  std::memcpy(data, out.data(), out.size());
  return out.size();
}

}  // namespace fuzz
