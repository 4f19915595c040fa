// Runs before anything is installed: imports only Node's own modules.
import { spawnSync } from 'node:child_process';
import { existsSync, readdirSync, statSync } from 'node:fs';
import { delimiter, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

export const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

const OLDEST_NODE = [20, 19];

/** Exits with one line if this Node is too old for the tools. */
function checkNodeVersion() {
  const [major, minor] = process.versions.node.split('.').map(Number);
  if (major > OLDEST_NODE[0] || (major === OLDEST_NODE[0] && minor >= OLDEST_NODE[1])) return;
  fail(
    `Node ${process.versions.node} is too old: ${OLDEST_NODE.join('.')} or newer is needed (https://nodejs.org).`,
  );
}

/**
 * Folders with their own manifest and lock, outside of the workspaces, so that the root installs
 * quickly. Packages that may exist only once, such as React and three, are links to the root's.
 */
export const PROJECTS = {
  'apps/lab/peers': 'the renderers that the lab compares with',
  'apps/docs': 'what builds the documentation site',
  'apps/examples': 'drei and a physics engine for the examples',
  'e2e/three/oldest': 'the oldest three that is supported',
  'packages/tools/package-checks': 'what checks packages, their sizes and dead code',
  'packages/tools/second-webgpu': 'Deno, and what drives Firefox',
};

/** Whether a lock's packages are installed and up to date. `folder` is relative to the root. */
export function isInstalled(folder) {
  // npm writes this file at the end of an installation.
  const installed = resolve(repositoryRoot, folder, 'node_modules/.package-lock.json');
  const lock = resolve(repositoryRoot, folder, 'package-lock.json');
  return existsSync(installed) && statSync(installed).mtimeMs >= statSync(lock).mtimeMs;
}

/** Installs the packages of a lock, prints one line, and returns whether it worked. */
export function install(folder) {
  const isRoot = folder === '.';
  const where = isRoot ? '' : ` in ${folder}`;
  const what = isRoot ? 'dependencies' : PROJECTS[folder];
  console.error(`Installing ${what} (npm ci${where}), from npm’s registry or its cache …`);
  const npm = process.env.npm_execpath;
  const args = isRoot ? ['ci'] : ['ci', '--ignore-scripts'];
  // stdout is reserved for the command that needs the packages.
  const options = { cwd: join(repositoryRoot, folder), stdio: ['inherit', 2, 2] };
  const { status } = npm
    ? spawnSync(process.execPath, [npm, ...args], options)
    : spawnSync(`npm ${args.join(' ')}`, { ...options, shell: true });
  return status === 0;
}

/** Installs the packages of the repository and of `projects`, if missing or outdated. */
export function ensureInstalled(...projects) {
  checkNodeVersion();
  for (const folder of ['.', ...projects]) {
    if (isInstalled(folder) || install(folder)) continue;
    fail(
      'The dependencies could not be installed; npm’s messages are above. Without a network, npm’s cache must hold them.',
    );
  }
}

/**
 * Returns the path of a Chromium for the end-to-end tests. Its package includes SwiftShader, on
 * which GPU tests run without a GPU. Installs it if no confirmation is needed; otherwise prints
 * instructions and exits.
 */
export function ensureChromium() {
  const found = findChromium();
  if (found) return found;
  if (process.env.CHROMIUM_PATH) fail(`CHROMIUM_PATH is ${process.env.CHROMIUM_PATH}, which does not exist.`);
  const command =
    process.platform === 'darwin'
      ? 'brew install --cask chromium'
      : 'sudo apt-get update && sudo apt-get install -y chromium';
  const remedy = `Install it with\n  ${command}\nor set CHROMIUM_PATH to the program.`;
  if (!isDebianRoot()) fail(`The tests need Chromium. ${remedy}`);
  const isInstalled = installPackages(['chromium']);
  const installed = findChromium();
  if (!isInstalled || !installed)
    fail(`The tests need Chromium, which apt-get could not install; its messages are above. ${remedy}`);
  return installed;
}

/**
 * Installs Firefox and a Vulkan CPU driver, for tests with a second WebGPU implementation. Returns
 * whether these tests must run. If the installation would need a confirmation, another system or a
 * network, prints which tests are skipped. In CI, a failed installation ends the process.
 *
 * @param {object} machine missing packages and rights of this machine, for tests.
 */
export function ensureSecondWebGpu({
  missing = missingPackages(),
  mayInstall = isDebianRoot(),
  install = installPackages,
  isCi = Boolean(process.env.CI),
} = {}) {
  if (missing.length > 0 && !(mayInstall && install(missing, '--no-install-recommends'))) {
    const names = missing.join(' and ');
    if (mayInstall && isCi) fail(`${names} could not be installed; apt-get’s messages are above.`);
    const command = `sudo apt-get update && sudo apt-get install -y ${missing.join(' ')}`;
    const why = mayInstall ? `apt-get could not install ${names}` : `${names} cannot be found`;
    console.warn(
      `Tests in Firefox and Deno will be skipped: ${why}. On Debian, install what they need with\n  ${command}`,
    );
    return false;
  }
  // npm has Deno for other processors too, but package-lock.json contains only this one.
  return process.arch === 'x64';
}

function missingPackages() {
  return SECOND_WEBGPU_PACKAGES.filter(({ isInstalled }) => !isInstalled()).map(({ name }) => name);
}

/** Debian packages of the second WebGPU implementation. */
const SECOND_WEBGPU_PACKAGES = [
  {
    name: 'firefox-esr',
    isInstalled: () =>
      Boolean(process.env.FIREFOX_PATH) ||
      existsSync('/usr/bin/firefox-esr') ||
      existsSync('/usr/bin/firefox'),
  },
  {
    name: 'mesa-vulkan-drivers',
    isInstalled: () => {
      const folder = '/usr/share/vulkan/icd.d';
      return existsSync(folder) && readdirSync(folder).some((name) => name.startsWith('lvp_icd'));
    },
  },
];

/** Whether packages of Debian or a derivative can be installed without a confirmation. */
function isDebianRoot() {
  return existsSync('/etc/debian_version') && process.getuid?.() === 0;
}

/**
 * Installs Debian packages, by default with their recommended packages; returns whether it worked.
 */
function installPackages(names, options = '') {
  console.log(`Installing ${names.join(' and ')} (apt-get) …`);
  const { status } = spawnSync(`apt-get update && apt-get install -y ${options} ${names.join(' ')}`, {
    shell: true,
    stdio: ['ignore', 'inherit', 'inherit'],
    env: { ...process.env, DEBIAN_FRONTEND: 'noninteractive' },
  });
  return status === 0;
}

function findChromium() {
  if (process.env.CHROMIUM_PATH)
    return existsSync(process.env.CHROMIUM_PATH) ? process.env.CHROMIUM_PATH : undefined;
  const names = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable'];
  const onPath = (process.env.PATH ?? '')
    .split(delimiter)
    .flatMap((folder) => names.map((name) => join(folder, name)));
  const elsewhere = [
    '/usr/bin/chromium',
    '/opt/google/chrome/chrome',
    '/Applications/Chromium.app/Contents/MacOS/Chromium',
    '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome',
    'C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe',
  ];
  return [...onPath, ...elsewhere].find((path) => existsSync(path));
}

/** Prints `message` and ends the process with status 1. */
export function fail(message) {
  console.error(message);
  process.exit(1);
}

// `node packages/tools/setup.mjs PROJECT…`, for scripts of package.json.
if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href)
  ensureInstalled(...process.argv.slice(2));
