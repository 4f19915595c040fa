import { isDeepStrictEqual } from 'node:util';

/** Required fields of a published package's manifest besides its name and exports. */
const REQUIRED = ['description', 'keywords', 'license', 'engines', 'files', 'type', 'sideEffects'];
/** Published from CI only, with npm's signed provenance of commit and workflow. */
const PUBLISH_CONFIG = { access: 'public', provenance: true };

/**
 * Checks the manifests of all packages. Published packages have the fields that npm and its readers
 * need, and one version. Other packages cannot be published by mistake.
 *
 * @param {object} root the repository's own manifest.
 * @param {Record<string, object>} manifests by folder, e.g. `packages/core`.
 * @param {readonly string[]} published folders.
 * @returns {string[]} problems, one line each.
 */
export function manifestProblems(root, manifests, published) {
  const problems = [];
  const names = new Map(published.map((folder) => [manifests[folder].name, manifests[folder]]));
  for (const [folder, manifest] of Object.entries(manifests)) {
    const report = (problem) => problems.push(`${folder}/package.json: ${problem}`);
    if (!published.includes(folder)) {
      if (manifest.private !== true) report('it is not published, so "private" must be true');
      continue;
    }
    if (manifest.private) report('it is published, so it cannot be private');
    for (const field of REQUIRED) if (manifest[field] === undefined) report(`"${field}" is missing`);
    for (const field of ['license', 'engines', 'homepage', 'bugs'])
      if (!isDeepStrictEqual(manifest[field], root[field])) report(`"${field}" is not the repository's`);
    if (!isDeepStrictEqual(manifest.publishConfig, PUBLISH_CONFIG))
      report(`"publishConfig" must be ${JSON.stringify(PUBLISH_CONFIG)}`);
    // npm rejects provenance if this differs from the repository that CI has built.
    const repository = root.repository && { ...root.repository, directory: folder };
    if (!isDeepStrictEqual(manifest.repository, repository))
      report(`"repository" must be ${JSON.stringify(repository) ?? 'missing, as in the repository’s own'}`);
    for (const [name, range] of Object.entries(manifest.dependencies ?? {})) {
      const ours = names.get(name);
      if (!ours) report(`it depends on ${name}, which is not published with it`);
      else if (range !== ours.version) report(`it must depend on ${name} ${ours.version}, not ${range}`);
    }
  }
  const versions = new Set(published.map((folder) => manifests[folder].version));
  if (versions.size > 1)
    problems.push(`published packages have several versions: ${[...versions].join(', ')}`);
  return problems;
}

/**
 * Finds files that a packed manifest's `exports` name and its tarball lacks.
 *
 * @param {object} manifest as packed.
 * @param {ReadonlySet<string>} files paths in the tarball.
 * @returns {string[]} problems, one line each.
 */
export function missingExports(manifest, files) {
  const targetsOf = (value) =>
    typeof value === 'string' ? [value] : Object.values(value).flatMap(targetsOf);
  return targetsOf(manifest.exports)
    .filter((target) => !files.has(target.replace(/^\.\//, '')) && !target.includes('*'))
    .map((target) => `${manifest.name}: exports name ${target}, which is not packed`);
}
