// The lowest of 256 texels, of equal ones the first in row order; ends up in candidates[0].
shared reliability_texel candidates[reliability_groups];

bool before(reliability_texel a, reliability_texel b) {
  return a.reliability < b.reliability || (a.reliability == b.reliability && a.number < b.number);
}

void keep_lowest(reliability_texel mine) {
  uint local = gl_LocalInvocationIndex;
  candidates[local] = mine;
  for (uint half_size = reliability_groups / 2u; half_size > 0u; half_size /= 2u) {
    barrier();
    if (local < half_size && before(candidates[local + half_size], candidates[local]))
      candidates[local] = candidates[local + half_size];
  }
}
