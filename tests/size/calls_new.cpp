int* Offend(int value) { return new int(value); }
