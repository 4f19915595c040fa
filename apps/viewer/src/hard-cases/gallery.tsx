import type { HardCase } from '@websplatter/hardcases';
import { type KeyboardEvent, useDeferredValue, useEffect, useMemo, useRef, useState } from 'react';
import { DropZone } from '../file-drop/drop-zone.tsx';
import type { FileDropDecision } from '../file-drop/file-drop.ts';
import { formatCount } from '../words/format.ts';
import {
  addressOf,
  type CaseGroup,
  filteredCases,
  groupedCases,
  groupTitle,
  isOpenable,
  noteOn,
} from './catalogue.ts';
import './gallery.css';

/** The page that lists all hard cases, to be searched and opened. */
export function Gallery({
  cases,
  firstQuery,
  onOpen,
}: {
  cases: readonly HardCase[];
  firstQuery: string;
  /** Files were dropped. */
  onOpen: (dropped: FileDropDecision) => void;
}) {
  const [query, setQuery] = useState(firstQuery);
  const found = useMemo(() => filteredCases(cases, query), [cases, query]);
  // Read out when typing pauses, not with every letter.
  const count = useDeferredValue(found.length);
  const page = useRef<HTMLElement>(null);
  const search = useRef<HTMLInputElement>(null);

  useEffect(() => {
    // Coming back from a case, or sending the address to somebody, finds the same list.
    const address = new URL(location.href);
    if (query) address.searchParams.set('q', query);
    else address.searchParams.delete('q');
    history.replaceState(history.state, '', address);
  }, [query]);

  const onKeyDown = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !page.current) return;
    const isSearching = event.target === search.current;
    if (event.key === '/' && !isSearching) search.current?.focus();
    else if (event.key === 'Escape' && query) {
      setQuery('');
      search.current?.focus();
    } else if (event.key === 'ArrowDown' || event.key === 'ArrowUp') {
      const stops = [search.current, ...page.current.querySelectorAll<HTMLElement>('[data-case]')];
      const next = stops.indexOf(event.target as HTMLElement) + (event.key === 'ArrowDown' ? 1 : -1);
      // From anywhere else the first arrow goes to the first case.
      stops[Math.max(0, Math.min(stops.length - 1, next))]?.focus();
    } else return;
    event.preventDefault();
  };

  return (
    <main className="gallery" ref={page} onKeyDown={onKeyDown} data-testid="gallery">
      <header className="gallery-head">
        <a href="?" className="gallery-home">
          WebSplatter
        </a>
        <h1>Hard cases</h1>
        <p>
          Small scenes that break splat renderers, each with the fault that it provokes. Tests compare every
          image with float64.
        </p>
      </header>
      <search className="gallery-search">
        <input
          ref={search}
          type="search"
          aria-label="Search hard cases"
          aria-keyshortcuts="/"
          placeholder="Name, group or fault"
          value={query}
          onChange={(event) => setQuery(event.target.value)}
          // biome-ignore lint/a11y/noAutofocus: searching is what the page is for, and nothing comes before it.
          autoFocus
          autoComplete="off"
          spellCheck={false}
          data-testid="gallery-search"
        />
        <p role="status" data-testid="gallery-count">
          {count === cases.length
            ? `${formatCount(count)} cases`
            : `${formatCount(count)} of ${formatCount(cases.length)}`}
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
          <GallerySection key={group.group} {...group} />
        ))}
        {found.length === 0 && (
          <p className="gallery-none">
            No case has “{query}” in its name, group or description.{' '}
            <button type="button" className="disclosure" onClick={() => setQuery('')}>
              Show all
            </button>
          </p>
        )}
      </div>
      <DropZone onDrop={onOpen} />
    </main>
  );
}

function GallerySection({ group, cases }: CaseGroup) {
  return (
    <section id={group} aria-labelledby={`${group}-title`} className="gallery-section">
      <h2 id={`${group}-title`}>
        {groupTitle(group)} <small>{formatCount(cases.length)}</small>
      </h2>
      <ul>
        {cases.map((hardCase) => (
          <li key={hardCase.name} data-testid="gallery-case">
            <CaseEntry hardCase={hardCase} />
          </li>
        ))}
      </ul>
    </section>
  );
}

function CaseEntry({ hardCase }: { hardCase: HardCase }) {
  const { name, breaks } = hardCase;
  const note = noteOn(hardCase);
  const text = (
    <>
      <strong>{name}</strong>
      <span>{breaks}</span>
      {note && <em>{note}</em>}
    </>
  );
  return isOpenable(hardCase) ? (
    <a className="gallery-case" href={addressOf(name)} data-case={name}>
      {text}
    </a>
  ) : (
    <div className="gallery-case">{text}</div>
  );
}
