/** The adapter that this page is built for; runner/build-pages.ts says which file it is. */
declare module 'virtual:peer-adapter' {
  const loadPeer: import('../adapter.ts').LoadPeer;
  export default loadPeer;
  export const formats: import('../adapter.ts').PeerFormats | undefined;
}
