import {
  HARD_CASES,
  type HardCase,
  type KeptRun,
  keptSentence,
  type CaseVerdict as Verdict,
  verdictOn,
} from '@websplatter/conformance';
import { formatCount } from '@websplatter/kit/format';
import { groupTitle, noteOn } from '@websplatter/kit/hard-cases';
import { type KeyboardEvent, memo, useDeferredValue, useRef } from 'react';
import { CaseVerdict, caseAddress } from '../page.tsx';
import type { CaseImages, ImageCase } from './case-images.ts';
import { inPlace } from './case-page.tsx';
import { CaseThumbnail } from './case-thumbnail.tsx';
import { type CaseGroup, groupedCases, hasImage } from './catalogue.ts';

/** Props of each case in the gallery. */
interface CaseProps {
  readonly images: CaseImages;
  readonly onGo: (name: string) => void;
}

interface SectionProps extends CaseProps {
  /** Verdicts of the cases that this device has tested; null before the first test. */
  readonly kept: KeptRun | null;
}

/** The page that lists all hard cases, with a search. */
export function Gallery({
  found,
  query,
  onQuery,
  isHidden,
  ...sectionProps
}: SectionProps & {
  /** The cases that match `query`. */
  found: readonly HardCase[];
  query: string;
  onQuery: (query: string) => void;
  /** Whether a case's page is shown instead. */
  isHidden: boolean;
}) {
  // Announced when typing pauses, not after every letter.
  const count = useDeferredValue(found.length);
  const { kept } = sectionProps;
  const page = useRef<HTMLElement>(null);
  const search = useRef<HTMLInputElement>(null);

  const onKeyDown = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !page.current) return;
    const isSearching = event.target === search.current;
    if (event.key === '/' && !isSearching) search.current?.focus();
    else if (event.key === 'Escape' && query) {
      onQuery('');
      search.current?.focus();
    } else if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      const stops = [search.current, ...page.current.querySelectorAll<HTMLElement>('[data-case]')];
      const next = stops.indexOf(event.target as HTMLElement) + (event.key === 'ArrowDown' ? 1 : -1);
      // If no entry has the focus, the first arrow key goes to the first case.
      stops[Math.max(0, Math.min(stops.length - 1, next))]?.focus();
    } else return;
    event.preventDefault();
  };

  return (
    <main className="gallery" ref={page} hidden={isHidden} onKeyDown={onKeyDown} data-testid="gallery">
      <header className="gallery-head">
        <h1>Hard cases</h1>
        <p>
          Small scenes that splat renderers get wrong, each with what goes wrong elsewhere. Here, tests
          compare every image with float64.{' '}
          <a href="?conformance">{kept ? 'Run them again' : 'Run all of them on this device'}</a>
        </p>
        {kept && (
          <p className="gallery-verdict" data-testid="gallery-verdict">
            {keptSentence(kept)}
          </p>
        )}
      </header>
      <search className="gallery-search">
        <input
          ref={search}
          type="search"
          aria-label="Search hard cases"
          aria-keyshortcuts="/"
          placeholder="Name, group or fault"
          value={query}
          onChange={(event) => onQuery(event.target.value)}
          // biome-ignore lint/a11y/noAutofocus: the page is for searching and begins with it.
          autoFocus
          autoComplete="off"
          spellCheck={false}
          data-testid="gallery-search"
        />
        <p role="status" data-testid="gallery-count">
          {count === HARD_CASES.length
            ? `${formatCount(count)} cases`
            : `${formatCount(count)} of ${formatCount(HARD_CASES.length)}`}
        </p>
      </search>
      <nav className="gallery-groups" aria-label="Groups">
        <ul>
          {groupedCases(found).map(({ group, cases: members }) => (
            <li key={group}>
              <a href={`#${group}`}>
                {groupTitle(group)} <small>{formatCount(members.length)}</small>
              </a>
            </li>
          ))}
        </ul>
      </nav>
      <div className="gallery-list">
        {groupedCases(found).map((group) => (
          <GallerySection key={group.group} {...group} {...sectionProps} />
        ))}
        {found.length === 0 && (
          <p className="gallery-none">
            No case has “{query}” in its name, group or description.{' '}
            <button type="button" className="disclosure" onClick={() => onQuery('')}>
              Show all
            </button>
          </p>
        )}
      </div>
    </main>
  );
}

function GallerySection({ group, cases, kept, ...caseProps }: CaseGroup & SectionProps) {
  return (
    <section id={group} aria-labelledby={`${group}-title`} className="gallery-section">
      <h2 id={`${group}-title`}>
        {groupTitle(group)} <small>{formatCount(cases.length)}</small>
      </h2>
      <ul>
        {cases.map((hardCase) => (
          <li key={hardCase.name} data-testid="gallery-case">
            <CaseEntry hardCase={hardCase} verdict={verdictOn(hardCase.name, kept)} {...caseProps} />
          </li>
        ))}
      </ul>
    </section>
  );
}

/** Memoized: typing in the search must not render every case again. */
const CaseEntry = memo(function CaseEntry({
  hardCase,
  verdict,
  images,
  onGo,
}: CaseProps & { hardCase: HardCase; verdict: Verdict }) {
  const { name, breaks } = hardCase;
  const note = noteOn(hardCase);
  return (
    <a className="gallery-case" href={caseAddress(name)} data-case={name} onClick={inPlace(() => onGo(name))}>
      {hasImage(hardCase) && !droppedCount(hardCase) ? (
        <CaseThumbnail hardCase={hardCase} images={images} />
      ) : (
        <span className="gallery-thumbnail" aria-hidden="true">
          {hasImage(hardCase) ? `${droppedCount(hardCase)} left out` : WITHOUT_IMAGE[hardCase.kind]}
        </span>
      )}
      <span>
        <span className="gallery-name">
          <strong>{name}</strong> <CaseVerdict verdict={verdict} />
        </span>
        <span>{breaks}</span>
        {note && <em>{note}</em>}
      </span>
    </a>
  );
});

/** Number of a case's splats that the reader drops; the picture shows only the others. */
function droppedCount({ dropped = {} }: ImageCase): number {
  return Object.values(dropped).reduce((sum, count) => sum + count, 0);
}

/** Text in place of an image. */
const WITHOUT_IMAGE: Readonly<Record<HardCase['kind'], string>> = {
  scene: 'no pixels',
  device: 'no pixels',
  'refused-file': 'refused',
  framing: 'camera',
  sort: 'keys',
  arithmetic: 'numbers',
};
