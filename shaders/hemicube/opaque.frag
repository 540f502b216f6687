#version 450 core

flat in uint polygon_id;
layout(location = 0) out uint id;

void main() { id = polygon_id; }
