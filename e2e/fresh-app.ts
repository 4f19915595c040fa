import { execFile, spawn } from 'node:child_process';
import { mkdir, mkdtemp, readFile, rename, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { PACKED, toolEnvironment } from './built-apps.ts';
import { builtApp } from './server.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));

/** Packages of this repository that every app depends on; core comes with them. */
const OURS = ['@websplatter/react', '@websplatter/three'];
/** Default dependencies, at the versions of this repository's lockfile. */
const DEPENDENCIES = ['@react-three/fiber', 'react', 'react-dom', 'three'];

/** Parts of an app besides its dependencies. */
export interface FreshAppParts {
  /** Names of its dependencies; default React, three, react-three-fiber and our packages. */
  readonly dependencies?: readonly string[];
  /** Packages at the versions of this repository's lockfiles: the root's and esbuild's. */
  readonly lockedPackages?: readonly string[];
  /** Other packages, each with its exact version. */
  readonly packages?: Readonly<Record<string, string>>;
  /** Further entries of package.json. */
  readonly manifest?: Readonly<Record<string, unknown>>;
  /** Source files: texts by path. */
  readonly sources: Readonly<Record<string, string>>;
  /** Files below `public`: contents by name. */
  readonly files?: Readonly<Record<string, Uint8Array>>;
}

export interface FreshApp {
  /** Runs a tool of the app's node_modules; rejects with its output if it fails. */
  run(script: string, args: readonly string[]): Promise<void>;
  /**
   * Replaces a piece of one of the app's files atomically: readers find no half-written file.
   * Resolves to a function that undoes the edit, for later tests.
   */
  edit(path: string, find: string, replacement: string): Promise<() => Promise<void>>;
  /** Starts a server by a tool of the app's node_modules, which prints its URL. */
  serve(
    script: string,
    args: readonly string[],
  ): Promise<{ readonly url: string; readonly close: () => Promise<void> }>;
  /** Path of the app. */
  readonly folder: string;
  remove(): Promise<void>;
}

/**
 * Makes an app outside of this repository, as a newcomer would: installs this repository's packages
 * from packed tarballs, and all other packages in exact versions.
 */
export async function makeFreshApp({
  dependencies = [...OURS, ...DEPENDENCIES],
  lockedPackages = [],
  packages: pinned = {},
  manifest: more = {},
  sources,
  files = {},
}: FreshAppParts): Promise<FreshApp> {
  const folder = await mkdtemp(join(tmpdir(), 'websplatter-fresh-'));
  const env = {
    ...toolEnvironment(),
    NO_COLOR: '1',
    NEXT_TELEMETRY_DISABLED: '1',
    // npm records this system's compilers alone; Next would ask a registry for the others.
    NEXT_IGNORE_INCORRECT_LOCKFILE: '1',
  };
  const runNode = async (path: string, args: readonly string[]) => {
    try {
      return await promisify(execFile)(process.execPath, [path, ...args], { cwd: folder, env });
    } catch (error) {
      const { message, stdout, stderr } = error as Error & { stdout: string; stderr: string };
      throw new Error(`${message}\n${stdout}${stderr}`);
    }
  };
  const tool = (script: string) => join(folder, 'node_modules', script);

  const packed = new Map(
    [...(await builtApp(PACKED)).matchAll(/^(@websplatter\/\S+) (.+\.tgz)$/gm)].map(([, name, path]) => [
      name,
      `file:${path}`,
    ]),
  );
  const packages = {
    // drei is in the lockfile of the examples only.
    ...(dependencies.includes('@react-three/drei') && (await locked('apps/examples'))),
    ...(await locked('packages/tools/package-checks')),
    ...(await locked('.')),
  };
  const versionsOf = (names: readonly string[]) =>
    names.map((name): [string, string] => [name, packages[`node_modules/${name}`].version]);
  const manifest = {
    name: 'fresh',
    private: true,
    type: 'module',
    dependencies: Object.fromEntries(
      dependencies.map((name) => [name, packed.get(name) ?? packages[`node_modules/${name}`].version]),
    ),
    devDependencies: { ...Object.fromEntries(versionsOf(lockedPackages)), ...pinned },
    // The packages depend on each other, and no registry has them.
    overrides: Object.fromEntries(packed),
    ...more,
  };
  // npm takes the versions that this app needs from it, without asking a registry.
  const lock = {
    lockfileVersion: 3,
    packages: {
      '': manifest,
      ...Object.fromEntries(
        Object.entries(packages).filter(([path, { link }]) => path.startsWith('node_modules/') && !link),
      ),
    },
  };
  const texts = {
    ...sources,
    'package.json': JSON.stringify(manifest),
    'package-lock.json': JSON.stringify(lock),
  };
  for (const [path, content] of [
    ...Object.entries(texts),
    ...Object.entries(files).map(([name, bytes]): [string, Uint8Array] => [`public/${name}`, bytes]),
  ]) {
    await mkdir(dirname(join(folder, path)), { recursive: true });
    await writeFile(join(folder, path), content);
  }
  const flags = ['--prefer-offline', '--ignore-scripts', '--no-audit', '--no-fund'];
  await promisify(execFile)('npm', ['install', ...flags], {
    cwd: folder,
    env,
    shell: process.platform === 'win32',
  });

  return {
    run: async (script, args) => {
      await runNode(tool(script), args);
    },
    edit: async (path, find, replacement) => {
      const file = join(folder, path);
      const text = await readFile(file, 'utf8');
      if (!text.includes(find)) throw new Error(`There is no ${find} in ${path}.`);
      // Written in place, the file is empty for as long as this process waits for a core. Vite then
      // serves an empty module, and drops the second change if it comes within 50 ms of the first.
      // No server watches node_modules.
      const beside = join(folder, 'node_modules', '.edited');
      const write = async (contents: string) => {
        await writeFile(beside, contents);
        await rename(beside, file);
      };
      await write(text.replace(find, replacement));
      return () => write(text);
    },
    serve: async (script, args) => {
      const child = spawn(process.execPath, [tool(script), ...args], {
        cwd: folder,
        env,
        stdio: ['ignore', 'pipe', 'pipe'],
      });
      const ended = new Promise<void>((resolve) => child.once('close', () => resolve()));
      const url = await new Promise<string>((resolve, reject) => {
        let printed = '';
        const read = (text: string) => {
          printed += text;
          const address = /http:\/\/(?:127\.0\.0\.1|localhost)(:\d+)/.exec(printed);
          if (address) resolve(`http://127.0.0.1${address[1]}/`);
        };
        child.stdout.setEncoding('utf8').on('data', read);
        child.stderr.setEncoding('utf8').on('data', read);
        child.once('close', () => reject(new Error(`${script} ended:\n${printed}`)));
      });
      return {
        url,
        close: async () => {
          child.kill();
          await ended;
        },
      };
    },
    folder,
    remove: () => rm(folder, { recursive: true, force: true }),
  };
}

/** Packages of a lockfile of this repository, by path. */
async function locked(folder: string): Promise<Record<string, { version: string; link?: boolean }>> {
  return JSON.parse(await readFile(join(repositoryRoot, folder, 'package-lock.json'), 'utf8')).packages;
}
