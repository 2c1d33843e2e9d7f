/** A format that a file shows by its first bytes, whatever it is called. */
export interface FileFormat {
  readonly kind: "h5md" | "other";
  /** As in "x is a GSD file". */
  readonly name: string;
}

const MARKS: readonly (readonly [text: string, place: number, name: string])[] = [
  ["\x89HDF\r\n\x1a\n", 0, "an HDF5 file, as trajectories in H5MD are"],
  ["\xdf\x65\xdf\x65\xdf\x65\xdf\x65", 0, "a GSD file of HOOMD-blue"],
  ["CDF\x01", 0, "a netCDF file"],
  ["CDF\x02", 0, "a netCDF file"],
  ["CDF\x05", 0, "a netCDF file"],
  ["ITEM: ", 0, "a dump of LAMMPS"],
  ["CORD", 4, "a DCD trajectory"],
  ["\x00\x00\x07\xcb", 0, "an XTC trajectory of GROMACS"],
  ["\x00\x00\x07\xc9", 0, "a TRR trajectory of GROMACS"],
  ["GRIDLOCK", 0, "a checkpoint of Gridlock"],
  ["\x93NUMPY", 0, "an array of NumPy"],
  ["PK\x03\x04", 0, "a ZIP archive, as .npz files are"],
  ["BZh", 0, "a file that bzip2 packed"],
  ["\xfd7zXZ", 0, "a file that xz packed"],
  ["\x28\xb5\x2f\xfd", 0, "a file that Zstandard packed"],
  ["\x89PNG\r\n", 0, "a picture (PNG)"],
  ["%PDF-", 0, "a PDF file"],
  ["ftyp", 4, "a movie (MP4)"],
  ["GIF8", 0, "a picture or movie (GIF)"],
  ["\x1a\x45\xdf\xa3", 0, "a movie (WebM or Matroska)"],
  ["<?xml", 0, "an XML file, as those of VTK are"],
  ["<VTKFile", 0, "an XML file of VTK"],
  ["# vtk DataFile", 0, "a file of VTK"],
  ["LAMMPS data", 0, "a data file of LAMMPS"],
  ["\x1f\x8b", 0, "a file that gzip packed"],
];

/** As many bytes as recognizeFormat() looks at. */
export const BYTES_OF_FORMAT = 16;

/** The format whose mark a file begins with; nothing for texts without a mark, such as XYZ. Contract: the table of src/io/file_format.cpp. */
export function recognizeFormat(head: Uint8Array): FileFormat | undefined {
  const text = String.fromCharCode(...head.subarray(0, BYTES_OF_FORMAT));
  const found = MARKS.find(([mark, place]) => text.startsWith(mark, place));
  return found && { kind: found[0].startsWith("\x89HDF") ? "h5md" : "other", name: found[2] };
}
