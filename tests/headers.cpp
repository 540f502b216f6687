// Nothing of its own: the target that the tests share precompiled headers with (SIGHTCELL_QUICK_BUILD).
int main() {}
