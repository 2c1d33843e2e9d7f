import { defineConfig } from "vitest/config";
import { engine } from "./vite_engine.ts";
import { folder, SINGLE_FILE, singleFile } from "./vite_single_file.ts";

export default defineConfig(({ mode }) => ({
  base: "./",
  plugins: [engine(), mode === SINGLE_FILE ? singleFile() : folder()],
  build: {
    outDir: "../build-web/page",
    emptyOutDir: mode !== SINGLE_FILE,
    target: "es2022",
    assetsInlineLimit: Number.MAX_SAFE_INTEGER,
    chunkSizeWarningLimit: 10_000,
    rolldownOptions: { output: { codeSplitting: false } },
  },
  // One file after the other: two browsers on two cores draw too slowly for tests that wait for pictures.
  test: { testTimeout: 60_000, hookTimeout: 60_000, fileParallelism: false, expect: { poll: { timeout: 20_000 } } },
  // A script that needs no other file and imports nothing can be started from a page on a disk.
  worker: { format: "iife", plugins: () => [engine()] },
}));
