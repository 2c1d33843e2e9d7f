// The command `gridlock view`: it needs a library for HTTP, whose libraries would make every start of gridlock slower.
#include "gridlock/verbs.hpp"
#include "view.hpp"

int main(int argc, char** argv) {
  return gridlock::cli::command_line_of_one(argc, argv, "view", gridlock::view::add_view);
}
