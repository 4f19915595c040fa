import { join } from 'node:path';
import {
  Application,
  Comment,
  type CommentDisplayPart,
  CommentTag,
  Converter,
  DeclarationReflection,
  makeRecursiveVisitor,
  type ProjectReflection,
  type Reflection,
  ReflectionKind,
  type SomeType,
} from 'typedoc';
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
  linkExamples(project);
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
        .getChildrenByKind(ReflectionKind.Function | ReflectionKind.Class | ReflectionKind.Variable)
        .filter((each) => isCallable(each) && !each.name.endsWith('Error') && !hasExample(each))
        .map(({ name }) => `${module.name}: ${name}`),
    );
}

/** Whether an export is a function or a class; among variables, effects are, which are in lower case. */
function isCallable({ kind, name }: DeclarationReflection): boolean {
  return kind !== ReflectionKind.Variable || /^[a-z]/.test(name);
}

function hasExample({ comment, signatures = [] }: DeclarationReflection): boolean {
  const comments = [comment, ...signatures.map((signature) => signature.comment)];
  return comments.some((each) => each?.getTag('@example'));
}

/** Most links to examples on the page of a type. */
const MOST_LINKS = 3;

/** Links each type without an example to the examples of the exports that lead to it by the fewest steps. */
function linkExamples(project: ProjectReflection): void {
  const all = (project.children ?? []).flatMap(({ children = [] }) => children);
  const leading = new Map<Reflection, Reflection[]>();
  const withExamples = all.filter(hasExample);
  let reached = new Map(withExamples.map((each) => [each, new Set([each])]));
  while (reached.size > 0) {
    const next = new Map<DeclarationReflection, Set<DeclarationReflection>>();
    for (const [from, starts] of reached)
      for (const to of typesIn(from)) {
        if (leading.has(to) || hasExample(to)) continue;
        const known = next.get(to) ?? new Set();
        for (const start of starts) known.add(start);
        next.set(to, known);
      }
    for (const [type, starts] of next) leading.set(type, [...starts].slice(0, MOST_LINKS));
    reached = next;
  }
  for (const [type, starts] of leading) {
    if (!all.includes(type as DeclarationReflection)) continue;
    type.comment ??= new Comment();
    const links = starts.flatMap((target): CommentDisplayPart[] => [
      { kind: 'text', text: ', ' },
      { kind: 'inline-tag', tag: '@link', text: target.name, target },
    ]);
    const text = `Example${starts.length > 1 ? 's' : ''} of `;
    type.comment.blockTags.push(new CommentTag('@see', [{ kind: 'text', text }, ...links.slice(1)]));
  }
}

/** Declarations that the types of `declaration` name. */
function typesIn(declaration: DeclarationReflection): DeclarationReflection[] {
  const found: DeclarationReflection[] = [];
  const visitor = makeRecursiveVisitor({
    reference({ reflection }) {
      if (reflection instanceof DeclarationReflection) found.push(reflection);
    },
    reflection({ declaration: inner }) {
      visit(inner);
    },
  });
  const visit = ({ type, signatures, children, getSignature }: DeclarationReflection) => {
    type?.visit(visitor);
    for (const child of children ?? []) visit(child);
    for (const signature of [...(signatures ?? []), ...(getSignature ? [getSignature] : [])]) {
      signature.type?.visit(visitor);
      for (const parameter of signature.parameters ?? []) parameter.type?.visit(visitor);
    }
  };
  visit(declaration);
  return found;
}
