#include "../scene/src/second_reader.cpp"
