/// <reference types="vitest/config" />
import { defineConfig, loadEnv } from 'vite';

export default defineConfig(({ mode }) => {
  // Where `npm run dev` finds a running `tyndall serve`; the built page talks to its own origin.
  const env = loadEnv(mode, '.', 'TYNDALL_');
  const server = env.TYNDALL_SERVER ?? 'http://127.0.0.1:8080';
  return {
    // Relative, so that the page also works below a path of a reverse proxy.
    base: './',
    build: {
      target: 'es2022',
      assetsInlineLimit: 0,
      // An inline module-preload polyfill would break a strict Content-Security-Policy.
      modulePreload: { polyfill: false },
    },
    server: {
      proxy: {
        '/v1': { target: server, ws: true, changeOrigin: true, rewriteWsOrigin: true },
        '/version': server,
      },
    },
    test: { include: ['tests/**/*.test.ts'], environment: 'node' },
  };
});
