// What the C library asks for, for a test that compares it with another reader.
// usage: sightcell-test-stream-requests SITE    standard input: "x y z fx fy fz wide high" per line
// Prints per line the cell and the pages that are requested, after all chunks around the eye were delivered.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "sightcell/stream.h"

namespace {

std::vector<char> contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Delivers the chunks that the view asks for.
bool load_chunks(sightcell_stream* stream, sightcell_stream_view* view, const std::string& site) {
  std::vector<sightcell_stream_request> requests(1000);
  std::size_t count = 0;
  if (sightcell_stream_view_requests(view, 0.0f, requests.data(), requests.size(), &count) != SIGHTCELL_OK)
    return false;
  for (std::size_t i = 0; i < count && requests[i].reason == SIGHTCELL_STREAM_FOR_LOOKUP; ++i) {
    sightcell_stream_file file;
    if (sightcell_stream_describe_file(stream, requests[i].file, &file) != SIGHTCELL_OK) return false;
    const std::vector<char> bytes = contents(site + "/" + file.name);
    if (sightcell_stream_deliver(stream, requests[i].file, bytes.data(), bytes.size()) != SIGHTCELL_OK) return false;
  }
  return true;
}

bool print_requests(sightcell_stream* stream, sightcell_stream_view* view, std::uint32_t cell) {
  sightcell_stream_info info{};
  info.struct_size = sizeof info;
  if (sightcell_stream_describe(stream, &info) != SIGHTCELL_OK) return false;
  std::vector<sightcell_stream_request> requests(info.file_count);
  std::size_t count = 0;
  if (sightcell_stream_view_requests(view, 0.0f, requests.data(), requests.size(), &count) != SIGHTCELL_OK)
    return false;
  std::printf("%u", cell);
  for (std::size_t i = 0; i < count; ++i) {
    sightcell_stream_file file;
    if (sightcell_stream_describe_file(stream, requests[i].file, &file) != SIGHTCELL_OK) return false;
    if (file.kind == SIGHTCELL_STREAM_PAGE && requests[i].reason == SIGHTCELL_STREAM_FOR_CELL)
      std::printf(" %u", file.number);
  }
  std::puts("");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::string site = argv[1];
  const std::vector<char> front = contents(site + "/scene.front");
  sightcell_stream* stream = nullptr;
  sightcell_stream_view* view = nullptr;
  if (sightcell_stream_open(front.data(), front.size(), 1 << 24, nullptr, &stream) != SIGHTCELL_OK) return 1;
  if (sightcell_stream_view_create(stream, &view) != SIGHTCELL_OK) return 1;
  bool good = true;
  sightcell_stream_pose pose{};
  pose.up[1] = 1.0f;
  while (good && std::cin >> pose.eye[0] >> pose.eye[1] >> pose.eye[2] >> pose.forward[0] >> pose.forward[1] >>
                     pose.forward[2] >> pose.half_width >> pose.half_height) {
    sightcell_stream_frame frame;
    good = sightcell_stream_view_move(view, &pose, &frame) == SIGHTCELL_OK && load_chunks(stream, view, site) &&
           sightcell_stream_view_move(view, &pose, &frame) == SIGHTCELL_OK && print_requests(stream, view, frame.cell);
  }
  sightcell_stream_view_destroy(view);
  sightcell_stream_close(stream);
  return good ? 0 : 1;
}
