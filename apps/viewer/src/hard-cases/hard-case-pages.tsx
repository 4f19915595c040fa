import type { HardCase } from '@websplatter/conformance';
import { useCallback, useEffect, useMemo, useState } from 'react';
import type { FileDropDecision } from '../engine/file-drop.ts';
import { DropZone } from '../scene/drop-zone.tsx';
import '../ui/page.css';
import { caseAddress, GALLERY_ADDRESS } from '../engine/case-addresses.ts';
import { closestNames, filteredCases, neighboursOf } from '../engine/catalogue.ts';
import type { CaseImages } from './case-images.ts';
import { CasePage } from './case-page.tsx';
import { Gallery } from './gallery.tsx';
import { useCaseImages } from './use-case-images.ts';

/**
 * The gallery of hard cases (`?scene=hard`, with `&q=` as search) and the page of each case
 * (`&case=`), without page loads in between.
 */
export function HardCasePages({
  cases,
  onOpen,
}: {
  cases: readonly HardCase[];
  /** Called when files are dropped. */
  onOpen: (dropped: FileDropDecision) => void;
}) {
  const [query, setQuery] = useState(() => parameter('q') ?? '');
  const [name, setName] = useState(() => parameter('case'));
  const images = useCaseImages(true);
  const found = useMemo(() => filteredCases(cases, query), [cases, query]);
  const go = useCallback((to: string | null) => {
    history.pushState(null, '', addressWith('case', to));
    setName(to);
  }, []);

  useEffect(() => {
    const onPopState = () => {
      setName(parameter('case'));
      setQuery(parameter('q') ?? '');
    };
    window.addEventListener('popstate', onPopState);
    return () => window.removeEventListener('popstate', onPopState);
  }, []);
  useEffect(() => {
    // The URL restores the same list.
    history.replaceState(history.state, '', addressWith('q', query || null));
  }, [query]);
  useEffect(() => {
    document.title = `${name ?? 'Hard cases'} · WebSplatter`;
    document.documentElement.dataset.state = 'ready';
    // Restores the list's scroll position after Back from a case.
    return () => {
      if (name !== null) requestAnimationFrame(() => entryOf(name)?.focus());
    };
  }, [name]);

  if (!images) return null;
  return (
    <>
      <Gallery
        cases={cases}
        found={found}
        query={query}
        onQuery={setQuery}
        isHidden={name !== null}
        images={images}
        onGo={go}
      />
      {name !== null && <CaseOrNone cases={cases} found={found} name={name} images={images} onGo={go} />}
      <DropZone onDrop={onOpen} />
    </>
  );
}

function CaseOrNone(props: {
  cases: readonly HardCase[];
  found: readonly HardCase[];
  name: string;
  images: CaseImages;
  onGo: (name: string | null) => void;
}) {
  const { cases, found, name, images, onGo } = props;
  const hardCase = cases.find((candidate) => candidate.name === name);
  if (!hardCase) return <NoCase name={name} cases={cases} />;
  // A linked case that the search does not match has all cases as neighbours.
  const neighbours = neighboursOf(found.includes(hardCase) ? found : cases, name);
  return <CasePage hardCase={hardCase} {...neighbours} images={images} onGo={onGo} />;
}

function NoCase({ name, cases }: { name: string; cases: readonly HardCase[] }) {
  const similar = closestNames(
    cases.map((candidate) => candidate.name),
    name,
  );
  return (
    <main className="page" data-testid="no-case">
      <header className="page-head">
        <p className="page-trail">
          <a href={GALLERY_ADDRESS}>All hard cases</a>
        </p>
        <h1>No such case</h1>
        <p role="alert">
          There is no hard case “{name}”{similar.length > 0 ? '. These have similar names:' : '.'}
        </p>
        <p className="page-trail">
          {similar.map((each) => (
            <a key={each} href={caseAddress(each)}>
              {each}
            </a>
          ))}
        </p>
      </header>
    </main>
  );
}

function entryOf(name: string): HTMLElement | null {
  return document.querySelector<HTMLElement>(`[data-case="${CSS.escape(name)}"]`);
}

function parameter(name: 'q' | 'case'): string | null {
  return new URLSearchParams(location.search).get(name);
}

/** The page's URL with one parameter changed; null removes it. */
function addressWith(name: 'q' | 'case', value: string | null): string {
  const address = new URL(location.href);
  if (value === null) address.searchParams.delete(name);
  else address.searchParams.set(name, value);
  // The fragment names a group in the list, so it does not apply to a case.
  if (name === 'case') address.hash = '';
  return address.href;
}
