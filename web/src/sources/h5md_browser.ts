import { File, ready } from "h5wasm";

import type { Bytes } from "./bytes.ts";
import { H5mdFile, useHdf5 } from "./h5md_file.ts";
import { readHead } from "./hdf5_head.ts";
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
export async function openH5md(file: WorkerFile, bytes: Bytes): Promise<H5mdFile> {
  const { hasWriter } = await readHead(bytes);
  const module = await ready;
  useHdf5(module);
  const files = module.FS as unknown as FileSystem;
  files.mkdir(FOLDER);
  if (file.blob !== undefined) files.mount(files.filesystems.WORKERFS, { blobs: [{ name: "file.h5", data: file.blob }] }, FOLDER);
  else files.createLazyFile(FOLDER, "file.h5", file.address as string, true, false);
  return new H5mdFile(file.name, openHdf5(file.name, `${FOLDER}/file.h5`, hasWriter));
}

function openHdf5(name: string, path: string, hasWriter: boolean): File {
  try {
    return new File(path, hasWriter ? "Sr" : "r");
  } catch {
    throw new SourceError(`${name} cannot be opened: it is damaged.`, "gridlock info says more of a trajectory.");
  }
}
