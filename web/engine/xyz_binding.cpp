// The functions that xyz_reader.ts calls, so that the page reads extended XYZ as the program does.

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <cmath>
#include <optional>
#include <string>

#include "answer.hpp"
#include "io/xyz_shown.hpp"

namespace gridlock::web {

namespace {

double number_or_nan(std::optional<double> const& number) { return number.value_or(std::nan("")); }

val value_of(xyz::ShownFrame const& frame) {
  val value = val::object();
  value.set("step", number_or_nan(frame.step));
  value.set("time", number_or_nan(frame.time));
  if (frame.sides) {
    val box = val::object();
    box.set("width", (*frame.sides)[0]);
    box.set("height", (*frame.sides)[1]);
    auto const [periodic_x, periodic_y] = frame.is_periodic;
    val both = val::array();
    both.call<void>("push", periodic_x);
    both.call<void>("push", periodic_y);
    box.set("periodic", periodic_x == periodic_y ? val(periodic_x) : both);
    box.set("shift", frame.shift);
    value.set("box", box);
  }
  value.set("ids", array_of(frame.ids));
  val columns = val::array();
  for (xyz::ShownColumn const& column : frame.columns) {
    val one = val::object();
    one.set("name", column.name);
    one.set("values", array_of(column.values));
    columns.call<void>("push", one);
  }
  value.set("columns", columns);
  val notes = val::array();
  for (std::string const& note : frame.notes) notes.call<void>("push", note);
  value.set("notes", notes);
  return value;
}

/// Reads a frame from bytes; `first_line` is the number of their first line in the file `name`.
val read_frame(val const& bytes, std::string const& name, int first_line) {
  return answer([&] {
    std::string const text = bytes_of(bytes);
    return value_of(xyz::read_shown(TextReader(text, name), first_line));
  });
}

val read_head(val const& bytes, std::string const& name, int first_line) {
  return answer([&] {
    std::string const text = bytes_of(bytes);
    return value_of(xyz::read_shown_head(TextReader(text, name), first_line));
  });
}

}  // namespace

EMSCRIPTEN_BINDINGS(gridlock_xyz) {
  emscripten::function("readFrame", &read_frame);
  emscripten::function("readHead", &read_head);
}

}  // namespace gridlock::web
