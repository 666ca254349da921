void Offend(const int* value) { delete value; }
