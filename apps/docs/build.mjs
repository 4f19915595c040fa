// `npm run docs:build`: builds the documentation site into apps/docs/dist. `-- --base /some/path/`
// is the path under which it will be served, `-- --out FOLDER` another folder to build it into.
import { resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { createServer } from 'vite';

const { values } = parseArgs({ options: { base: { type: 'string' }, out: { type: 'string' } } });
if (values.base && !/^\/(?:.*\/)?$/.test(values.base)) {
  console.error(`--base is “${values.base}”; it begins and ends with a slash, e.g. /websplatter/.`);
  process.exit(2);
}

// A server of Vite's is for development unless told otherwise, and what it then builds is so, too.
process.env.NODE_ENV = 'production';
// Node 20 runs no TypeScript: Vite does, and its import.meta.glob, which lists the examples.
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
  // Of bundlers' errors, too, all but the message is a long list of files.
  console.error(error.message);
  process.exitCode = 1;
} finally {
  await server.close();
}
