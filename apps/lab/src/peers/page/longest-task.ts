/**
 * Watches for tasks that block the page; the returned function ends that and tells the longest, ms,
 * 0 for none above 50 ms.
 */
export function watchLongTasks(): () => number {
  let longestMs = 0;
  const note = (entries: PerformanceEntryList) => {
    for (const { duration } of entries) longestMs = Math.max(longestMs, duration);
  };
  const observer = new PerformanceObserver((list) => note(list.getEntries()));
  observer.observe({ type: 'longtask' });
  return () => {
    note(observer.takeRecords());
    observer.disconnect();
    return longestMs;
  };
}
