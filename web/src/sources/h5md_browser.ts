import { File, ready } from "h5wasm";

import { H5mdFile } from "./h5md_file.ts";
import { SourceError } from "./source.ts";
import type { WorkerFile } from "./source_worker.ts";

const FOLDER = "/opened";

/** What is used of Emscripten's file system, which h5wasm does not describe. */
interface FileSystem {
  mkdir(path: string): void;
  mount(type: unknown, options: object, path: string): void;
  createLazyFile(folder: string, name: string, address: string, canRead: boolean, canWrite: boolean): void;
  readonly filesystems: { readonly WORKERFS: unknown };
}

/**
 * Opens a file in H5MD in a worker, without reading more of it than is shown: a file of the user's by FileReaderSync, one on the
 * server by requests for ranges. A file that another program is writing, or whose writer was killed, is opened too.
 */
export async function openH5md(file: WorkerFile): Promise<H5mdFile> {
  const files = (await ready).FS as unknown as FileSystem;
  files.mkdir(FOLDER);
  if (file.blob !== undefined) files.mount(files.filesystems.WORKERFS, { blobs: [{ name: "file.h5", data: file.blob }] }, FOLDER);
  else files.createLazyFile(FOLDER, "file.h5", file.address as string, true, false);
  return new H5mdFile(file.name, openHdf5(file.name, `${FOLDER}/file.h5`));
}

function openHdf5(name: string, path: string): File {
  for (const mode of ["r", "Sr"] as const) {
    try {
      const file = new File(path, mode);
      if (file.file_id >= 0n) return file;
    } catch {
      // The next mode is for files with the mark of a writer.
    }
  }
  throw new SourceError(`${name} cannot be opened: it is no HDF5 file, or it is damaged or cut off.`, "Is the file whole? gridlock info says more of a trajectory.");
}
