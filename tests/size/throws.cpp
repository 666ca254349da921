void Offend(int value) { throw value; }
