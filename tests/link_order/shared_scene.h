#pragma once

// 0 when the file is refused, which standard error then says.
extern "C" [[gnu::visibility("default")]] unsigned polygons_of(const char* path);
