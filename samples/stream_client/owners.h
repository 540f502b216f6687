#pragma once
// The C interface of streamed scenes, with owners.
#include <memory>

#include "sightcell/stream.h"

namespace stream_client {

struct stream_closer {
  void operator()(sightcell_stream* stream) const { sightcell_stream_close(stream); }
  void operator()(sightcell_stream_view* view) const { sightcell_stream_view_destroy(view); }
};

using stream_owner = std::unique_ptr<sightcell_stream, stream_closer>;
using view_owner = std::unique_ptr<sightcell_stream_view, stream_closer>;

// Fails with client.stream if a call that cannot fail here did.
void require(sightcell_status status, const char* call);

}  // namespace stream_client
