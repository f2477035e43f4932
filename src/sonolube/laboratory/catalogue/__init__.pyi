from .entry import CatalogueEntry as CatalogueEntry, catalogue_entry as catalogue_entry
from .index import (
    CATALOGUE as CATALOGUE,
    FoundRuns as FoundRuns,
    RunQuery as RunQuery,
    query_from as query_from,
    query_runs as query_runs,
)
from .measured import (
    CATALOGUE_PREFIX as CATALOGUE_PREFIX,
    catalogued_runs as catalogued_runs,
    level_rows as level_rows,
    take_in as take_in,
)
