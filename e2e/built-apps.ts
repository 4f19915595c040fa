import { execFile } from 'node:child_process';
import { cp, mkdtemp, rm } from 'node:fs/promises';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import type { TestProject } from 'vitest/node';

declare module 'vitest' {
  interface ProvidedContext {
    /** Place where test files ask for a built app, by the app's folder, and for packed packages; see `builtApp`. */
    builtAppsUrl: string;
  }
}

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));

/** Built apps that all projects of a run share. It is global, because each project loads this module anew. */
const run = globalThis as {
  builtApps?: { users: number; isLabUsed: boolean; readonly started: ReturnType<typeof startBuilding> };
};

/** Builds each requested app, and packs packages, once for all test files, which run in processes of their own. */
export default async function provideBuiltApps(project: TestProject): Promise<() => Promise<void>> {
  run.builtApps ??= { users: 0, isLabUsed: false, started: startBuilding() };
  const shared = run.builtApps;
  shared.users++;
  // All projects are set up before the first test asks for an app.
  shared.isLabUsed ||= project.name !== 'smoke';
  const { url, close } = await shared.started;
  project.provide('builtAppsUrl', url);
  return async () => {
    if (--shared.users > 0) return;
    delete run.builtApps;
    await close();
  };
}

/** Starts the server that test files ask for built apps. */
async function startBuilding(): Promise<{ readonly url: string; readonly close: () => Promise<void> }> {
  const root = await mkdtemp(join(tmpdir(), 'websplatter-apps-'));
  const builds = new Map<string, Promise<string>>();
  const built = (appFolder: string): Promise<string> => {
    const build = builds.get(appFolder) ?? make(appFolder, join(root, appFolder.replaceAll('/', '-')));
    builds.set(appFolder, build);
    return build;
  };
  const make = async (appFolder: string, outDir: string) => {
    if (appFolder === PACKED) return packPackages(outDir);
    await buildApp(appFolder, outDir);
    // The viewer has the lab beside it, as it is shipped, except where no test opens the lab.
    if (appFolder === 'apps/viewer' && run.builtApps?.isLabUsed)
      await cp(await built('apps/lab'), join(outDir, 'lab'), { recursive: true });
    return outDir;
  };
  const server = createServer(async (request, response) => {
    try {
      response.end(await built(decodeURIComponent(request.url!.slice(1))));
    } catch (error) {
      response.writeHead(500).end(String(error));
    }
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {
    url: `http://127.0.0.1:${(server.address() as AddressInfo).port}`,
    close: async () => {
      server.closeAllConnections();
      server.close();
      await rm(root, { recursive: true, force: true });
    },
  };
}

/** What `builtApp` takes in place of an app's folder, to have the packages packed. */
export const PACKED = 'packages';

/** Packs packages into `outDir` and returns what that prints: a line per package with its tarball. */
async function packPackages(outDir: string): Promise<string> {
  const script = join(repositoryRoot, 'packages/tools/pack.mjs');
  return (await promisify(execFile)(process.execPath, [script, outDir], { env: toolEnvironment() })).stdout;
}

/** The environment for tools: Vitest's NODE_ENV and export conditions would change what they build. */
export function toolEnvironment(): NodeJS.ProcessEnv {
  const { NODE_ENV: _, NODE_OPTIONS: __, npm_config_local_prefix: ___, ...env } = process.env;
  return env;
}

/** Path of an app's configuration: in its folder, or a file; both relative to the root. */
export function configFileOf(app: string): string {
  return join(repositoryRoot, app.endsWith('.ts') ? app : `${app}/vite.config.ts`);
}

/** Builds an app into `outDir`. */
async function buildApp(appFolder: string, outDir: string): Promise<void> {
  const vite = join(repositoryRoot, 'node_modules/vite/bin/vite.js');
  const args = ['build', '--config', configFileOf(appFolder), '--outDir', outDir, '--logLevel', 'error'];
  await promisify(execFile)(process.execPath, [vite, ...args], { env: toolEnvironment() });
}
