#include "verbs.hpp"

int main(int argc, char** argv) { return gridlock::cli::command_line(argc, argv, gridlock::cli::add_paper); }
