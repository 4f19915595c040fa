// `npm run docs:build`: builds the documentation site into apps/docs/dist. `-- --base /some/path/`
// sets the path under which it will be served; `-- --out FOLDER` sets another output folder.
import { resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { createServer } from 'vite';

const { values } = parseArgs({ options: { base: { type: 'string' }, out: { type: 'string' } } });
if (values.base && !/^\/(?:.*\/)?$/.test(values.base)) {
  console.error(`--base is “${values.base}”; it begins and ends with a slash, e.g. /websplatter/.`);
  process.exit(2);
}

// Vite servers default to development mode, which would also apply to the builds that run in it.
process.env.NODE_ENV = 'production';
// Node 20 cannot run TypeScript. Vite can, and also provides import.meta.glob, which lists the
// examples.
const server = await createServer({
  configFile: false,
  root: fileURLToPath(new URL('.', import.meta.url)),
  mode: 'production',
  logLevel: 'error',
  appType: 'custom',
  server: { middlewareMode: true, hmr: false, ws: false, watch: null },
  optimizeDeps: { noDiscovery: true, include: [] },
});
try {
  const { buildSite } = await server.ssrLoadModule('/src/build/build-site.ts');
  await buildSite({ base: values.base, outDir: values.out && resolve(values.out), log: console.log });
} catch (error) {
  // The rest of a bundler's error is a long list of files.
  console.error(error.message);
  process.exitCode = 1;
} finally {
  await server.close();
}
