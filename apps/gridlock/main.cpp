#include "gridlock/command_line.hpp"

int main(int argc, char** argv) { return gridlock::command_line(argc, argv); }
