import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  build: { outDir: "../build-web/page", emptyOutDir: true, target: "es2022" },
  worker: { format: "es" },
});
