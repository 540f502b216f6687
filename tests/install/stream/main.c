// Opens a front that is none, and one with a wrong zlib stream.
#include <sightcell/stream.h>
#include <stdio.h>

int main(void) {
  char front[64] = "SIGHTFRT\1\0\0\0\11\0\0\0";
  sightcell_stream* stream = NULL;
  const sightcell_status other = sightcell_stream_open("no front at all", 15, 1 << 20, NULL, &stream);
  const sightcell_status damaged = sightcell_stream_open(front, sizeof front, 1 << 20, NULL, &stream);
  puts(sightcell_status_text(damaged));
  sightcell_stream_close(stream);
  return other == SIGHTCELL_ERR_NOT_OURS && damaged == SIGHTCELL_ERR_CORRUPT ? 0 : 1;
}
