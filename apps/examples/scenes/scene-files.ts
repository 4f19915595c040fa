import { fileURLToPath } from 'node:url';
import { type Plugin, runnerImport } from 'vite';

/** The files that the examples show. Code makes them, so that the repository needs no captures. */
const SCENE_FILES = ['still-life.ply', 'ring.ply'] as const;

/** Makes them by the packages' sources, which run in the page, too: otherwise these would have to be built. */
async function sceneFile(name: (typeof SCENE_FILES)[number]): Promise<Uint8Array> {
  const path = fileURLToPath(new URL('./make-scenes.ts', import.meta.url));
  const resolve = { conditions: ['@websplatter/source'], noExternal: [/^@websplatter\//] };
  const { module } = await runnerImport<typeof import('./make-scenes.ts')>(path, {
    configFile: false,
    logLevel: 'error',
    environments: { inline: { resolve } },
  });
  return name === 'ring.ply' ? module.ringPly() : module.stillLifePly();
}

/** Serves the scenes as files next to the app, and builds them into it. */
export function sceneFiles(): Plugin {
  return {
    name: 'scene-files',
    configureServer({ middlewares }) {
      for (const name of SCENE_FILES) {
        middlewares.use(`/${name}`, async (_request, response, next) => {
          try {
            const bytes = await sceneFile(name);
            response.setHeader('content-type', 'application/octet-stream');
            response.end(bytes);
          } catch (error) {
            next(error);
          }
        });
      }
    },
    async generateBundle() {
      for (const name of SCENE_FILES)
        this.emitFile({ type: 'asset', fileName: name, source: await sceneFile(name) });
    },
  };
}
