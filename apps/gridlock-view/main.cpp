// The command `gridlock view`, a program of its own, since loading its HTTP library would slow every start of gridlock.
#include "gridlock/verbs.hpp"
#include "view.hpp"

int main(int argc, char** argv) {
  return gridlock::cli::command_line_of_one(argc, argv, "view", gridlock::view::add_view);
}
