import type { ApiEntry } from './api-entries.ts';
import { SECTIONS, type Section } from './contents.ts';
import type { EditableExample } from './examples.ts';

/** Page data for the site's configuration. */
export interface SiteContents {
  readonly sections: readonly Section[];
}

/** All sidebar sections, with the generated pages of examples and API. */
export function siteContents(
  examples: readonly Pick<EditableExample, 'name' | 'title'>[],
  entries: readonly ApiEntry[],
): SiteContents {
  const exampleSection: Section = {
    text: 'Examples',
    pages: [
      { text: 'All examples', page: 'examples/index.md' },
      ...examples.map(({ name, title }) => ({ text: title, page: `examples/${name}.md` })),
    ],
  };
  const api: Section = {
    text: 'API',
    pages: [
      { text: 'All packages', page: 'api/index.md' },
      ...[...entries]
        .sort((a, b) => rank(a) - rank(b))
        .map(({ name }) => ({ text: `@websplatter/${name}`, page: `api/${name}/index.md` })),
    ],
  };
  return { sections: [...SECTIONS, exampleSection, api] };
}

/** Packages by the number of their readers. */
const READERS_FIRST = ['react', 'three', 'core', 'scenes'];

/** Whole packages come before their further entry points. */
function rank({ name }: ApiEntry): number {
  const [packageName, entry] = name.split('/');
  return READERS_FIRST.indexOf(packageName) + (entry ? READERS_FIRST.length : 0);
}
