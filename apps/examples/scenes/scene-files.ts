import type { Plugin } from 'vite';
import { ring } from './ring.ts';

/** The files that the examples show. Code makes them, so that the repository needs no captures. */
const SCENE_FILES = ['still-life.ply', 'ring.ply'] as const;

async function sceneFile(name: (typeof SCENE_FILES)[number]): Promise<Uint8Array> {
  // Imported when they are needed: a server of the built app never needs them.
  const { encodePly } = await import('@websplatter/core');
  const { stillLife } = await import('@websplatter/scenes');
  return encodePly(name === 'ring.ply' ? ring() : stillLife({ splats: 60_000, shDegree: 1 }));
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
