import { defineConfig } from "vite";

export default defineConfig({
  // The report's style sheet is this page's too.
  server: { fs: { allow: [".."] }, proxy: { "/v1": process.env["STANDIN_SERVER"] ?? "http://127.0.0.1:8080" } },
  build: { target: "es2022", chunkSizeWarningLimit: 1000, modulePreload: { polyfill: false } },
});
