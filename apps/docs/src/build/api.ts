import { join } from 'node:path';
import { Application, Converter, type ProjectReflection, ReflectionKind, type SomeType } from 'typedoc';
import { type ApiEntry, apiEntries } from './api-entries.ts';
import { DocsError } from './markdown.ts';

/**
 * Writes one page per export of the packages into `folder`, from its docstring.
 *
 * @throws DocsError if TypeDoc cannot read the sources.
 */
export async function writeApi(root: string, folder: string): Promise<void> {
  const entries = apiEntries(root);
  const app = await Application.bootstrapWithPlugins({
    plugin: ['typedoc-plugin-markdown'],
    entryPoints: entries.map(({ source }) => join(root, source)),
    tsconfig: join(root, 'tsconfig.json'),
    // `npm run check` checks types, with this repository's compiler.
    skipErrorChecking: true,
    readme: 'none',
    sortEntryPoints: false,
    disableSources: true,
    disableGit: true,
    excludeExternals: true,
    excludePrivate: true,
    excludeProtected: true,
    excludeInternal: true,
    // Types in signatures that no entry point exports are not linked.
    validation: { notExported: false, invalidLink: false, rewrittenLink: false },
    logLevel: 'Error',
    outputs: [{ name: 'markdown', path: folder }],
  });
  // Options of the plugin, which TypeDoc's types lack.
  for (const [name, value] of Object.entries({
    hidePageHeader: true,
    hideBreadcrumbs: true,
    entryFileName: 'index',
    modulesFileName: 'modules',
    useCodeBlocks: true,
    indexFormat: 'table',
    parametersFormat: 'table',
    pageTitleTemplates: {
      index: () => 'API',
      module: ({ name }: { name: string }) => `@websplatter/${name}`,
      member: ({ name, kind }: { name: string; kind: string }) => `${kind}: ${name}`,
    },
    interfacePropertiesFormat: 'list',
    sanitizeComments: true,
    publicPath: '/api/',
  }))
    app.options.setValue(name as never, value as never);
  app.converter.on(Converter.EVENT_RESOLVE_END, ({ project }) => nameParameters(project));
  const project = await app.convert();
  if (!project) throw new DocsError('TypeDoc could not read the sources of the packages.');
  nameEntries(project, entries);
  const lacking = lackingExamples(project);
  if (lacking.length > 0) throw new DocsError(`These exports lack an @example: ${lacking.join(', ')}.`);
  await app.generateOutputs(project);
  if (app.logger.hasErrors()) throw new DocsError('TypeDoc has reported errors.');
}

/** Names destructured parameters by their types: `props` for SplatsProps. */
function nameParameters(project: ProjectReflection): void {
  for (const parameter of project.getReflectionsByKind(ReflectionKind.Parameter))
    if (parameter.name === '__namedParameters' && parameter.isParameter())
      parameter.name = lastWordOf(parameter.type);
}

function lastWordOf(type: SomeType | undefined): string {
  if (type?.type !== 'reference') return 'values';
  if (type.name === 'Pick') return lastWordOf(type.typeArguments?.[0]);
  return /[A-Z][a-z]*$/.exec(type.name)?.[0].toLowerCase() ?? 'values';
}

/** Renames modules to their import names; TypeDoc names them by the paths of their sources. */
function nameEntries(project: ProjectReflection, entries: readonly ApiEntry[]): void {
  const modules = project.children ?? [];
  if (modules.length !== entries.length)
    throw new DocsError(`TypeDoc has made ${modules.length} modules of ${entries.length} entry points.`);
  modules.forEach((module, i) => {
    module.name = entries[i].name;
  });
}

/** Entry points for tests and tools of this repository, and scenes to try things with. */
const WITHOUT_EXAMPLES: ReadonlySet<string> = new Set(['core/inspect', 'core/reference', 'scenes']);

/** Functions and classes without an `@example`. Error classes need none: messages tell the way out. */
function lackingExamples(project: ProjectReflection): string[] {
  return (project.children ?? [])
    .filter(({ name }) => !WITHOUT_EXAMPLES.has(name))
    .flatMap((module) =>
      module
        .getChildrenByKind(ReflectionKind.Function | ReflectionKind.Class)
        .filter(({ name, comment, signatures }) => {
          const comments = [comment, ...(signatures ?? []).map((signature) => signature.comment)];
          return !name.endsWith('Error') && !comments.some((each) => each?.getTag('@example'));
        })
        .map(({ name }) => `${module.name}: ${name}`),
    );
}
