// usage: sightcell-test-dump FILE.pvs
// Prints what the C runtime decodes. The output has the same bytes on every platform; cmp compares two machines.
#include <cstdio>

#include "decode_dump.h"

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#endif

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: sightcell-test-dump FILE.pvs\n");
    return 2;
  }
  sightcell_db* db = nullptr;
  if (const sightcell_status s = sightcell_db_open_file(argv[1], nullptr, &db); s != SIGHTCELL_OK) {
    std::fprintf(stderr, "sightcell-test-dump: %s: %s\n", argv[1], sightcell_status_text(s));
    return 1;
  }
  const std::string text = sightcell::test::dump(db);
  sightcell_db_close(db);
#if defined(_WIN32)
  static_cast<void>(_setmode(_fileno(stdout), _O_BINARY));
#endif
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0 ? 0 : 1;
}
